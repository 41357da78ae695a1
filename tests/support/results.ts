/** Results, as tests compare them. */
import type { Alignment } from "sim3align";

/** A result without its times, which differ from run to run. */
export function withoutTimes({ diagnostics, ...result }: Alignment) {
  const { timingsMs: _, ...others } = diagnostics;
  return { ...result, diagnostics: others };
}

/** Results, as tests compare them. */

/** A result without its times, which differ from run to run. */
export function withoutTimes<T extends { diagnostics: { timingsMs: unknown } }>({ diagnostics, ...result }: T) {
  const { timingsMs: _, ...others } = diagnostics as T["diagnostics"];
  return { ...result, diagnostics: others };
}

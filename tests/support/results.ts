/** Results, as tests compare them. */

/** A result without its times, which differ from run to run. */
export function withoutTimes<R extends { diagnostics: { timingsMs: object } }>({ diagnostics, ...result }: R) {
  const { timingsMs: _, ...others } = diagnostics;
  return { ...result, diagnostics: others };
}

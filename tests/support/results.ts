/** Results, as tests compare them. */

/** A result without its times, which differ from run to run. */
export function withoutTimes<R extends { diagnostics: { timingsMs: object } }>(
  result: R,
): Omit<R, "diagnostics"> & { diagnostics: Omit<R["diagnostics"], "timingsMs"> } {
  const { timingsMs: _, ...diagnostics } = result.diagnostics;
  return { ...result, diagnostics };
}

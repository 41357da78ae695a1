/** Errors of fetched data, in the parts of the package's own. */

/**
 * `UNKNOWN_DATASET`, `NOT_AVAILABLE` (the host does not answer or lacks a file), `INCOMPLETE` (a download ended early),
 * `CHECKSUM_MISMATCH`, `CORRUPT_FILE` (a damaged archive), `NO_CASES` (nothing fits the selection).
 * @typedef {"UNKNOWN_DATASET" | "NOT_AVAILABLE" | "INCOMPLETE" | "CHECKSUM_MISMATCH" | "CORRUPT_FILE" | "NO_CASES"} DataErrorCode
 */

/**
 * @param {DataErrorCode} code
 * @param {string} argument the file or address
 * @param {string} found
 * @param {string} expected
 * @param {string} remedy
 * @param {unknown} [cause]
 */
export const failure = (code, argument, found, expected, remedy, cause) =>
  Object.assign(new Error(`${argument}: found ${found}, expected ${expected}. Remedy: ${remedy}`, { cause }), {
    code,
    argument,
    found,
    expected,
    remedy,
  });

/** An invalid command line, which ends the program. */
export class UsageError extends Error {}

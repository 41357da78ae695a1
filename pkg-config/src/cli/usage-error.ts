/** The command line itself is wrong: no case would get further. */
export class UsageError extends Error {}

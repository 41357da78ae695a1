/** The order of names of files. */

const { compare } = new Intl.Collator("en", { numeric: true });

/** Compares names as people order them: `frame_2` comes before `frame_10`. Names that only look equal have an order, too. */
export const naturally = (a: string, b: string): number => compare(a, b) || (a < b ? -1 : Number(a > b));

/** Modules of the installed package that it does not export. */

/** The module at this path in the package. */
// biome-ignore lint/suspicious/noExplicitAny: their types are those of the sources, which the tests do not see.
export const internalModule = (path: string): Promise<any> =>
  import(new URL(`../../node_modules/sim3align/${path}`, import.meta.url).href);

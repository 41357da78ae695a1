/** Modules that the build puts into `inline.js`: see `scripts/lib/inline.mjs`. */

declare module "inlined:core" {
  /** The core module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:formats" {
  /** The file readers' module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:worker" {
  /** The worker's script, whole. */
  const script: string;
  export default script;
}

/** Modules that the build embeds in `inline.js`: see `scripts/lib/inline.mjs`. */

declare module "inlined:core" {
  /** The core module, gzipped, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:formats" {
  /** The formats module, gzipped, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:worker" {
  /** The complete worker script. */
  const script: string;
  export default script;
}

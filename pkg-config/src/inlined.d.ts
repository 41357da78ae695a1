/** Modules that the build embeds in `inline.js`: see `scripts/lib/inline.mjs`. */

declare module "inlined:*" {
  /** A WebAssembly module, gzipped, base64, or the complete worker script. */
  const content: string;
  export default content;
}

/** Modules that the build embeds in `inline.js`: see `scripts/lib/inline.mjs`. */

declare module "inlined:core" {
  /** The core module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:depth-files" {
  /** The depth-files module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:formats" {
  /** The formats module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:joint" {
  /** The joint module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:registration" {
  /** The registration module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:splats" {
  /** The splats module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:webp" {
  /** The WebP module, base64. */
  const base64: string;
  export default base64;
}

declare module "inlined:worker" {
  /** The complete worker script. */
  const script: string;
  export default script;
}

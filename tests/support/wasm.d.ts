/** WebAssembly imported as Cloudflare's bundler hands it over: compiled. */
declare module "*.wasm" {
  const module: WebAssembly.Module;
  export default module;
}

//! Writes the JavaScript around a WebAssembly module: `sim3align-bindgen web|tests INPUT FOLDER NAME`.

use std::error::Error;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [target, input, folder, name] = args.as_slice() else {
        return Err("expected web or tests, a module, a folder and a name".into());
    };
    let mut bindgen = Bindgen::new();
    bindgen.input_path(input).out_name(name);
    if target == "web" {
        // The package makes a new instance after a trap.
        bindgen.web(true)?.typescript(true).omit_default_module_path(false).reset_state_function(true);
    } else {
        // Tests are exports of the module itself.
        bindgen.nodejs(true)?.debug(true).export_wasm(true).emit_start(false);
    }
    Ok(bindgen.generate(folder)?)
}

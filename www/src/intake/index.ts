/** The intake, which is loaded when the first files arrive. */
export { Sheet } from "./sheet.js";

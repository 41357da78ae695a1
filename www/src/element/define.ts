/** Defines `<sim3-align>`. */
import { Sim3AlignElement } from "./element.js";

export { Sim3AlignElement };

// On servers, where a page is rendered, there are no elements.
const elements = globalThis.customElements as CustomElementRegistry | undefined;
if (elements?.get("sim3-align") === undefined) elements?.define("sim3-align", Sim3AlignElement);

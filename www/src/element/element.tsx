/** The custom element `<sim3-align>`. */

import { signal } from "@preact/signals";
import { render } from "preact";
import type { Sim3, Sim3Like } from "sim3align";
import { toSim3 } from "sim3align/conventions/similarity";
import controls from "../../style/controls.css?inline";
import own from "../../style/element.css?inline";
import panels from "../../style/panels.css?inline";
import theme from "../../style/theme.css?inline";
import views from "../../style/views.css?inline";
import { alignAll, refine } from "../alignment/align.js";
import { observePoses } from "../alignment/evaluate.js";
import { listenToKeys } from "../commands/shortcuts.js";
import { applyState } from "../session/pack.js";
import type { Options } from "../state/options.js";
import { createWorkspace } from "../state/workspace.js";
import { WorkspaceProvider } from "../ui/workspace.js";
import { Embedded } from "./embedded.js";
import { errorDetail, sendEvents } from "./events.js";
import { type ElementSession, poseOf, resultOf, sessionOf } from "./results.js";
import type * as host from "./sim3-align.js";
import type { ElementEvents, GivenInput, ObjectResult } from "./sim3-align.js";

let shared: CSSStyleSheet[] | undefined;

/** The sheets, which all instances share. */
function sheets(): CSSStyleSheet[] {
  shared ??= [theme, views, controls, panels, own].map((text) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(text);
    return sheet;
  });
  return shared;
}

const darkQuery = () => matchMedia("(prefers-color-scheme: dark)");

/** Servers that render import the element, but never create one. */
const Base = globalThis.HTMLElement ?? (class {} as typeof HTMLElement);

/** A scene with its objects, to be aligned and corrected. `docs/guides/embedding.md` describes it. */
export class Sim3AlignElement extends Base implements host.Sim3AlignElement {
  static readonly observedAttributes = ["src", "readonly", "theme"];

  readonly #theme = signal<"light" | "dark">("light");
  readonly #workspace = createWorkspace({ theme: this.#theme });
  readonly #root = this.attachShadow({ mode: "open" });
  #stops: (() => void)[] = [];
  #given: GivenInput | null = null;
  /** What was set before the scene was there. */
  #pendingPose: Sim3Like | null = null;
  #pendingSession: ElementSession | null = null;
  /** The number of the last scene. The results of earlier ones are discarded. */
  #lastCall = 0;

  constructor() {
    super();
    this.#root.adoptedStyleSheets = sheets();
    this.#workspace.announce("No scene.");
  }

  connectedCallback(): void {
    // Properties that were set before the element was defined hide those of the class.
    for (const name of ["scene", "pose", "selected", "options", "readonly", "session"] as const) {
      if (!Object.hasOwn(this, name)) continue;
      const value = this[name];
      delete (this as Record<string, unknown>)[name];
      Object.assign(this, { [name]: value });
    }
    const followTheme = () => this.#followTheme();
    followTheme();
    const query = darkQuery();
    query.addEventListener("change", followTheme);
    this.#stops = [
      () => query.removeEventListener("change", followTheme),
      sendEvents(this.#workspace, (type, detail) => this.#send(type, detail)),
      observePoses(this.#workspace),
      listenToKeys(this.#workspace, this.#root),
    ];
    const provided = (
      <WorkspaceProvider value={this.#workspace}>
        <Embedded />
      </WorkspaceProvider>
    );
    render(provided, this.#root);
  }

  disconnectedCallback(): void {
    this.#workspace.cancel();
    for (const stop of this.#stops.splice(0)) stop();
    render(null, this.#root);
  }

  attributeChangedCallback(name: string, _: string | null, value: string | null): void {
    if (name === "src" && value !== null) this.scene = value;
    if (name === "readonly") this.#workspace.isReadonly.value = value !== null;
    if (name === "theme") {
      this.style.colorScheme = value ?? "";
      this.#followTheme();
    }
  }

  /** The scene. Setting it shows it and, unless a pose or session is given with it, aligns it. */
  get scene(): GivenInput | null {
    return this.#given;
  }

  set scene(scene: GivenInput | null | undefined) {
    const given = scene ?? null;
    // What was set for a scene that never came is not for this one.
    if (this.#given !== null) [this.#pendingPose, this.#pendingSession] = [null, null];
    this.#given = given;
    const call = ++this.#lastCall;
    // What is set from now on is for this scene, which takes time to read.
    this.#workspace.scene.value = null;
    this.#workspace.announce("No scene.");
    if (given !== null) this.#open(given, () => call === this.#lastCall);
  }

  /** The pose of the selected object: OpenCV camera from mesh, metres; null before the first alignment. */
  get pose(): Sim3 | null {
    const object = this.#workspace.selected.peek();
    return object?.isPlaced ? poseOf(object) : null;
  }

  set pose(pose: Sim3Like | null) {
    const object = this.#workspace.selected.peek();
    if (object === null || pose === null) this.#pendingPose = pose;
    else {
      const alignment = object.alignment.peek();
      this.#workspace.place(object, { transform: toSim3(pose), source: "hand", alignment });
    }
  }

  /** The name of the selected object. */
  get selected(): string | null {
    return this.#workspace.selected.peek()?.name ?? null;
  }

  set selected(name: string | null) {
    const object = this.#workspace.scene.peek()?.objects.find((one) => one.name === name);
    this.#workspace.select(object?.id ?? null);
  }

  /** The options of the alignments. Those that are not set keep their values. */
  get options(): Options {
    return this.#workspace.options.peek();
  }

  set options(options: Partial<Options>) {
    const { options: known } = this.#workspace;
    for (const name of Object.keys(options)) {
      if (!(name in known.peek())) {
        throw new TypeError(`Unknown option ${name}. Known: ${Object.keys(known.peek()).join(", ")}.`);
      }
    }
    known.value = { ...known.peek(), ...options };
  }

  /** Whether the scene is read-only. */
  get readonly(): boolean {
    return this.hasAttribute("readonly");
  }

  set readonly(is: boolean) {
    this.toggleAttribute("readonly", is);
  }

  /** The results of all objects. */
  get results(): ObjectResult[] {
    return this.#workspace.objects.peek().map((object) => resultOf(this.#workspace, object));
  }

  /** Poses, decisions and options as plain data, to be kept and set again with the same scene. */
  get session(): ElementSession {
    return sessionOf(this.#workspace);
  }

  set session(session: ElementSession | null) {
    if (session === null) return;
    if (session.version !== 1) throw new TypeError(`Unknown version of the session: ${session.version}.`);
    if (this.#workspace.scene.peek() === null) this.#pendingSession = session;
    else applyState(session, this.#workspace);
  }

  /** Aligns all objects that are not locked. Resolves to the results; failures are in the events `error`. */
  async align(): Promise<ObjectResult[]> {
    await alignAll(this.#workspace);
    return this.results;
  }

  /** Refines the pose of the selected object. */
  async refine(): Promise<ObjectResult[]> {
    await refine(this.#workspace);
    return this.results;
  }

  async #open(given: GivenInput, isCurrent: () => boolean): Promise<void> {
    const { announce, isSettled, show } = this.#workspace;
    announce("Reading …", "working");
    try {
      // Readers of files are loaded with the first scene.
      const { readGiven } = await import("./given.js");
      const { scene, inputs, session } = await readGiven(given);
      if (!isCurrent()) return;
      show(scene, inputs, false);
      if (session !== null) applyState(session, this.#workspace);
      const isGiven = this.#applyPending() || session !== null;
      announce(`${scene.name} is open.`);
      this.#send("ready", { name: scene.name, objects: scene.objects.map(({ name }) => name) });
      if (!isGiven && !this.readonly && !this.hasAttribute("manual")) await alignAll(this.#workspace);
    } catch (cause) {
      if (!isCurrent()) return;
      const detail = errorDetail(cause);
      announce(detail.message, "failed");
      this.#send("error", detail);
    }
    isSettled.value = true;
  }

  /** Applies what was set before the scene was there. Returns whether that includes a pose. */
  #applyPending(): boolean {
    const [pose, session] = [this.#pendingPose, this.#pendingSession];
    this.#pendingPose = null;
    this.#pendingSession = null;
    if (session !== null) this.session = session;
    if (pose !== null) this.pose = pose;
    return pose !== null || session !== null;
  }

  #send<K extends keyof ElementEvents>(type: K, detail: ElementEvents[K]): void {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  /** Follows the colour scheme of the element, for the parts that CSS does not draw. */
  #followTheme(): void {
    const schemes = this.isConnected ? getComputedStyle(this).colorScheme : "";
    const isDark = schemes.includes("dark") && (darkQuery().matches || !schemes.includes("light"));
    this.#theme.value = isDark ? "dark" : "light";
  }
}

// On servers, where a page is rendered, there are no elements.
const elements = globalThis.customElements as CustomElementRegistry | undefined;
if (elements?.get("sim3-align") === undefined) elements?.define("sim3-align", Sim3AlignElement);

/** The stage: a canvas that fills its host, drawn when there is something new to see. */
import { type Color, type PerspectiveCamera, Scene, WebGPURenderer } from "three/webgpu";
import { isPresentable } from "./presentable.js";

/** Sharper than this, no eye can tell, and every frame takes longer. */
const mostPixelRatio = 2;

/** A device that is lost within this time after another one has something against what is drawn. */
const SOON_MS = 60_000;

/** Neither WebGPU nor WebGL 2 is there. */
export class NoGraphics extends Error {
  override name = "NoGraphics";
  constructor(cause?: unknown) {
    super("This browser offers neither WebGPU nor WebGL 2, so there is no 3D view.", { cause });
  }
}

/** What a stage tells, and asks. */
export interface StageEvents {
  /** Before each frame; whether another frame has to follow. */
  onFrame(widthPx: number, heightPx: number): boolean;
  /** The canvas has another size, in CSS pixels. */
  onResize(width: number, height: number): void;
  /** The graphics device was lost, and there is another canvas. */
  onCanvas(canvas: HTMLCanvasElement): void;
}

/** What there is to draw with; software draws all the same, but slowly. */
interface Graphics {
  isWebGpu: boolean;
  isSoftware: boolean;
}

interface Adapter {
  requestDevice?(): Promise<unknown>;
  readonly info?: { readonly isFallbackAdapter?: boolean; readonly architecture?: string };
}

const software = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether there is an adapter: to ask for a device without one would log a warning. */
async function webGpu(): Promise<Graphics | null> {
  try {
    const { gpu } = navigator as { gpu?: { requestAdapter(): Promise<Adapter | null> } };
    const adapter = await gpu?.requestAdapter();
    const info = adapter?.info;
    if (!adapter || !info) return null;
    const isSoftware = info.isFallbackAdapter === true || software.test(info.architecture ?? "");
    if (isSoftware && !(await isPresentable(adapter))) return null;
    return { isWebGpu: true, isSoftware };
  } catch {
    return null;
  }
}

function webGl(): Graphics | null {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return null;
  const info = context.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(context.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  // Browsers allow few contexts at a time.
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return { isWebGpu: false, isSoftware: software.test(name) };
}

/** Where WebGPU has just failed, the browser may have to start its graphics process anew. */
async function webGlSoon(): Promise<Graphics | null> {
  for (let i = 0; i < 8 && "gpu" in navigator; i++) {
    const found = webGl();
    if (found) return found;
    await new Promise((resolve) => setTimeout(resolve, 250));
  }
  return webGl();
}

/** A canvas and its renderer. */
export class Stage {
  readonly scene = new Scene();
  canvas = document.createElement("canvas");
  background: Color | null = null;
  private renderer: WebGPURenderer | null = null;
  private camera: PerspectiveCamera | null = null;
  private events: StageEvents | null = null;
  private readonly observer = new ResizeObserver(() => this.fit());
  private frame = 0;
  /** When a graphics device was lost, in milliseconds since the page began. */
  private lastLoss = Number.NEGATIVE_INFINITY;
  private isDisposed = false;
  private graphics: Graphics | null = null;

  private constructor(
    private readonly host: HTMLElement,
    private forceWebGL: boolean,
  ) {}

  /** Puts a canvas into the host. */
  static async create(host: HTMLElement, forceWebGL: boolean): Promise<Stage> {
    const stage = new Stage(host, forceWebGL);
    await stage.start();
    return stage;
  }

  get backend(): "webgpu" | "webgl" {
    return this.graphics?.isWebGpu ? "webgpu" : "webgl";
  }

  /** Whether no graphics card draws, but the processor: then less is drawn. */
  get isSoftware(): boolean {
    return this.graphics?.isSoftware === true;
  }

  private async start(): Promise<void> {
    const graphics = (this.forceWebGL ? null : await webGpu()) ?? (await webGlSoon());
    if (!graphics) throw new NoGraphics();
    const { canvas } = this;
    canvas.style.cssText = "display:block;position:absolute;inset:0;width:100%;height:100%;touch-action:none";
    canvas.setAttribute("role", "img");
    const renderer = new WebGPURenderer({
      canvas,
      antialias: !graphics.isSoftware,
      alpha: false,
      forceWebGL: !graphics.isWebGpu,
    });
    renderer.onDeviceLost = () => void this.recover();
    try {
      await renderer.init();
    } catch (error) {
      renderer.dispose();
      throw new NoGraphics(error);
    }
    if (this.isDisposed) return renderer.dispose();
    this.renderer = renderer;
    const isWebGpu = (renderer.backend as { isWebGPUBackend?: boolean }).isWebGPUBackend === true;
    this.graphics = { ...graphics, isWebGpu };
    if (getComputedStyle(this.host).position === "static") this.host.style.position = "relative";
    this.host.append(canvas);
  }

  /** Begins to draw. */
  run(camera: PerspectiveCamera, events: StageEvents): void {
    this.camera = camera;
    this.events = events;
    this.fit();
    this.observer.observe(this.host);
  }

  private fit(): void {
    const { clientWidth, clientHeight } = this.host;
    if (!this.renderer || clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(Math.min(this.isSoftware ? 1 : mostPixelRatio, devicePixelRatio));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.events?.onResize(clientWidth, clientHeight);
    // At once: a canvas that has been resized is empty.
    this.draw();
  }

  /** Draws soon. */
  invalidate(): void {
    if (this.frame !== 0 || this.isDisposed) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.draw();
    });
  }

  private draw(): void {
    const { renderer, camera, events } = this;
    if (!renderer || !camera || !events || this.canvas.width === 0) return;
    const isMoving = events.onFrame(this.canvas.width, this.canvas.height);
    if (this.background) renderer.setClearColor(this.background, 1);
    renderer.render(this.scene, camera);
    // The renderer asks for a frame after every frame, for animations that are not used here; each `render` starts anew.
    (renderer as unknown as { _animation?: { stop?(): void } })._animation?.stop?.();
    if (isMoving) this.invalidate();
  }

  /** A PNG of the canvas. */
  snapshot(): Promise<Blob> {
    // What was drawn lasts until the browser has shown it: so in the same task.
    this.draw();
    return new Promise((resolve, reject) =>
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new NoGraphics())), "image/png"),
    );
  }

  /** Another device; where that is lost soon too, one of WebGL 2; after that, a message. */
  private async recover(): Promise<void> {
    if (this.isDisposed) return;
    const [lost, label] = [this.renderer, this.canvas.getAttribute("aria-label")];
    this.renderer = null;
    const old = this.canvas;
    try {
      this.countLoss();
      this.canvas = document.createElement("canvas");
      await this.start();
      if (this.isDisposed) return;
      if (label) this.canvas.setAttribute("aria-label", label);
      this.events?.onCanvas(this.canvas);
      this.fit();
    } catch {
      const message = document.createElement("p");
      message.setAttribute("role", "alert");
      message.style.cssText = "position:absolute;inset:0;margin:auto;height:fit-content;padding:1rem;text-align:center";
      message.textContent = "The graphics device stopped working. Reload the page to get the 3D view back.";
      this.host.append(message);
    }
    old.remove();
    lost?.dispose();
  }

  private countLoss(): void {
    const now = performance.now();
    const isSoon = now - this.lastLoss < SOON_MS;
    this.lastLoss = now;
    if (!isSoon) return;
    if (this.backend === "webgl") throw new NoGraphics();
    this.forceWebGL = true;
    this.lastLoss = Number.NEGATIVE_INFINITY;
  }

  dispose(): void {
    this.isDisposed = true;
    cancelAnimationFrame(this.frame);
    this.observer.disconnect();
    this.renderer?.dispose();
    this.renderer = null;
    this.canvas.remove();
  }
}

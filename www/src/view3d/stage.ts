/** A canvas that fills its host, and its renderer. It draws on demand. */
import type { Color, OrthographicCamera, PerspectiveCamera } from "three/webgpu";
import { isPresentable } from "./presentable.js";
import { Scene, WebGPURenderer } from "./three.js";

/** Higher ratios take longer without a visible gain. */
const maxPixelRatio = 2;

/** A second loss of the device within this time is taken as caused by the content. */
const REPEATED_LOSS_MS = 60_000;

/** Error for browsers with neither WebGPU nor WebGL 2. */
export class NoGraphics extends Error {
  override name = "NoGraphics";
  constructor(cause?: unknown) {
    super("This browser supports neither WebGPU nor WebGL 2, so there is no 3D view.", { cause });
  }
}

/** Events of a stage. */
export interface StageEvents {
  /** Called before each frame, with the height in pixels and in those of CSS. Returns whether another frame must follow. */
  onFrame(heightPx: number, height: number): boolean;
  /** The canvas was resized, in CSS pixels. */
  onResize(width: number, height: number): void;
  /** A new canvas replaces the old one after the graphics device was lost. */
  onCanvas(canvas: HTMLCanvasElement): void;
}

/** The available graphics API, and whether it is rendered in software. */
interface Graphics {
  isWebGpu: boolean;
  isSoftware: boolean;
}

interface Adapter {
  requestDevice?(): Promise<unknown>;
  readonly info?: { readonly isFallbackAdapter?: boolean; readonly architecture?: string };
}

const software = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Where a device fails, asking for another one can end the graphics of all views, so the answer is kept. */
let asked: Promise<Graphics | null> | null = null;

function webGpu(): Promise<Graphics | null> {
  asked ??= askForWebGpu();
  return asked;
}

/** Checks for an adapter first, because requesting a device without one logs a warning. */
async function askForWebGpu(): Promise<Graphics | null> {
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
  // Browsers limit the number of contexts.
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return { isWebGpu: false, isSoftware: software.test(name) };
}

/** Retries, because the browser may have to restart its graphics process after WebGPU failed. */
async function webGlWithRetries(): Promise<Graphics | null> {
  for (let i = 0; i < 8 && "gpu" in navigator; i++) {
    const found = webGl();
    if (found) return found;
    await new Promise((resolve) => setTimeout(resolve, 250));
  }
  return webGl();
}

export class Stage {
  readonly scene = new Scene();
  canvas = document.createElement("canvas");
  background: Color | null = null;
  private renderer: WebGPURenderer | null = null;
  private camera: PerspectiveCamera | null = null;
  private events: StageEvents | null = null;
  private readonly observer = new ResizeObserver(() => this.fit());
  private frame = 0;
  /** The share of the host's width that the canvas takes. */
  private share = 1;
  /** Time of the last loss of a graphics device (`performance.now`). */
  private lastLoss = Number.NEGATIVE_INFINITY;
  private isDisposed = false;
  private graphics: Graphics | null = null;

  private constructor(
    private readonly host: HTMLElement,
    private forceWebGL: boolean,
  ) {}

  /** Creates the renderer and appends its canvas to the host. */
  static async create(host: HTMLElement, forceWebGL: boolean): Promise<Stage> {
    const stage = new Stage(host, forceWebGL);
    await stage.start();
    return stage;
  }

  get backend(): "webgpu" | "webgl" {
    return this.graphics?.isWebGpu ? "webgpu" : "webgl";
  }

  /** Whether rendering is done in software. The view then draws less. */
  get isSoftware(): boolean {
    return this.graphics?.isSoftware === true;
  }

  private async start(): Promise<void> {
    const graphics = (this.forceWebGL ? null : await webGpu()) ?? (await webGlWithRetries());
    if (!graphics) throw new NoGraphics();
    const { canvas } = this;
    canvas.style.cssText = "display:block;position:absolute;inset:0;height:100%;touch-action:none";
    canvas.style.width = `${100 * this.share}%`;
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

  /** Starts drawing. */
  run(camera: PerspectiveCamera, events: StageEvents): void {
    this.camera = camera;
    this.events = events;
    this.fit();
    this.observer.observe(this.host);
  }

  /** Leaves a part of the host's width to others. */
  setShare(share: number): void {
    this.share = share;
    this.canvas.style.width = `${100 * share}%`;
    this.fit();
  }

  fit(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (!this.renderer || clientWidth === 0 || clientHeight === 0) return;
    this.resize(clientWidth, clientHeight, Math.min(this.isSoftware ? 1 : maxPixelRatio, devicePixelRatio));
    // At once, because resizing clears the canvas.
    this.draw();
  }

  private resize(width: number, height: number, pixelRatio: number): void {
    this.renderer?.setPixelRatio(pixelRatio);
    this.renderer?.setSize(width, height, false);
    this.events?.onResize(width, height);
  }

  /** Draws in the next frame. */
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
    const isMoving = events.onFrame(this.canvas.height, this.canvas.height / renderer.getPixelRatio());
    if (this.background) renderer.setClearColor(this.background, 1);
    renderer.render(this.scene, camera);
    // The renderer requests a frame after every frame, for animations that are not used here. `render` restarts it.
    (renderer as unknown as { _animation?: { stop?(): void } })._animation?.stop?.();
    if (isMoving) this.invalidate();
  }

  /**
   * Draws the scene as another camera sees it into a canvas of another size, at so many of its CSS pixels per metre. The next
   * frame replaces it here.
   */
  copy(
    camera: OrthographicCamera,
    to: CanvasRenderingContext2D,
    { width, height, pxPerM }: { width: number; height: number; pxPerM: number },
  ): void {
    const { canvas, renderer } = this;
    if (!renderer || canvas.width === 0 || canvas.height === 0) return;
    // The largest part with the sides' ratio of the other canvas.
    const scale = Math.min(canvas.width / width, canvas.height / height);
    const [halfWidth, halfHeight] = [canvas.width, canvas.height].map((side) => side / (2 * scale * pxPerM));
    Object.assign(camera, { left: -(halfWidth ?? 1), right: halfWidth, top: halfHeight, bottom: -(halfHeight ?? 1) });
    camera.updateProjectionMatrix();
    if (this.background) renderer.setClearColor(this.background, 1);
    renderer.render(this.scene, camera);
    const [cutWidth, cutHeight] = [scale * width, scale * height];
    const [left, top] = [(canvas.width - cutWidth) / 2, (canvas.height - cutHeight) / 2];
    to.drawImage(canvas, left, top, cutWidth, cutHeight, 0, 0, width, height);
  }

  /** A PNG of this size, in pixels; `fit` gives the canvas its own size back. */
  picture(width: number, height: number): Promise<Blob> {
    this.resize(width, height, 1);
    // In the same task, because the browser clears the drawing buffer after presenting it.
    this.draw();
    const taken = new Promise<Blob>((resolve, reject) =>
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new NoGraphics())), "image/png"),
    );
    return taken;
  }

  /** Replaces a lost device: by one of the same API, then by WebGL 2, then by a message. */
  private async recover(): Promise<void> {
    if (this.isDisposed) return;
    const [lost, label] = [this.renderer, this.canvas.getAttribute("aria-label")];
    this.renderer = null;
    asked = null;
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
    const isRepeated = now - this.lastLoss < REPEATED_LOSS_MS;
    this.lastLoss = now;
    if (!isRepeated) return;
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

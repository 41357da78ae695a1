/** Whether WebGPU's pictures reach the screen. */

/** As far as is needed here: the compiler's own declarations know nothing of WebGPU yet. */
interface Device {
  readonly lost: Promise<unknown>;
  readonly queue: { submit(commands: unknown[]): void; onSubmittedWorkDone(): Promise<void> };
  createCommandEncoder(): { beginRenderPass(descriptor: object): { end(): void }; finish(): unknown };
  destroy(): void;
}

interface CanvasContext {
  configure(configuration: object): void;
  getCurrentTexture(): { createView(): unknown };
}

/** Long enough for a processor that draws. */
const PATIENCE_MS = 2000;

/**
 * Draws one green pixel and looks at it. Some software adapters draw, and take the whole graphics process with them as
 * soon as a canvas is to be shown; WebGL 2 then works all the same.
 */
export async function isPresentable(adapter: { requestDevice?(): Promise<unknown> }): Promise<boolean> {
  const device = (await adapter.requestDevice?.()) as Device | undefined;
  if (device === undefined) return false;
  const late = new Promise<false>((resolve) => setTimeout(resolve, PATIENCE_MS, false));
  const lost = device.lost.then(() => false as const);
  try {
    return await Promise.race([isGreen(device), lost, late]);
  } catch {
    return false;
  } finally {
    device.destroy();
  }
}

async function isGreen(device: Device): Promise<boolean> {
  const canvas = new OffscreenCanvas(1, 1);
  const context = canvas.getContext("webgpu" as "2d") as unknown as CanvasContext | null;
  if (context === null) return false;
  context.configure({ device, format: "rgba8unorm", alphaMode: "opaque" });
  const view = context.getCurrentTexture().createView();
  const commands = device.createCommandEncoder();
  const attachment = { view, loadOp: "clear", storeOp: "store", clearValue: { r: 0, g: 1, b: 0, a: 1 } };
  commands.beginRenderPass({ colorAttachments: [attachment] }).end();
  device.queue.submit([commands.finish()]);
  const picture = canvas.transferToImageBitmap();
  const looking = new OffscreenCanvas(1, 1).getContext("2d");
  if (looking === null) return false;
  looking.drawImage(picture, 0, 0);
  const [red = 0, green = 0] = looking.getImageData(0, 0, 1, 1).data;
  return green > 200 && red < 50;
}

/** Tests whether WebGPU can present to a canvas. */

/** The used part of `GPUDevice`, which the TypeScript library does not declare yet. */
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

/** Time limit, sufficient for software renderers. */
const TIMEOUT_MS = 2000;

/**
 * Draws one green pixel and reads it back. Some software adapters render, but crash the graphics process when a canvas
 * is presented. WebGL 2 works in that case.
 */
export async function isPresentable(adapter: { requestDevice?(): Promise<unknown> }): Promise<boolean> {
  const device = (await adapter.requestDevice?.()) as Device | undefined;
  if (device === undefined) return false;
  const timeout = new Promise<false>((resolve) => setTimeout(resolve, TIMEOUT_MS, false));
  const lost = device.lost.then(() => false as const);
  try {
    return await Promise.race([isGreen(device), lost, timeout]);
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
  const image = canvas.transferToImageBitmap();
  const context2d = new OffscreenCanvas(1, 1).getContext("2d");
  if (context2d === null) return false;
  context2d.drawImage(image, 0, 0);
  const [red = 0, green = 0] = context2d.getImageData(0, 0, 1, 1).data;
  return green > 200 && red < 50;
}

/** A small picture that is computed. */
import { useEffect, useRef } from "preact/hooks";

interface PictureProps {
  /** Null draws nothing. */
  image: ImageData | null;
  /** Empty where a text beside the picture says it all. */
  label: string;
  class?: string;
}

const HIDDEN = { "aria-hidden": true } as const;

export function Picture({ image, label, class: className = "thumb" }: PictureProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current === null || image === null) return;
    canvas.current.width = image.width;
    canvas.current.height = image.height;
    canvas.current.getContext("2d")?.putImageData(image, 0, 0);
  }, [image]);
  return image === null ? (
    <span class={className} />
  ) : (
    <canvas ref={canvas} class={className} {...(label === "" ? HIDDEN : { role: "img", "aria-label": label })} />
  );
}

/** What the layout of the page does, measured in it. */

/** Screens from a phone to a desktop, width and height in pixels. */
export const screens = [
  [390, 844],
  [1024, 768],
  [1440, 900],
  [1920, 1080],
] as const;

/** Runs in the page: the parts that are cut, with lengths as those of a sofa. */
export function cutParts(): string[] {
  const shown = document.querySelector("#dimensions")?.firstElementChild;
  for (const [i, text] of ["123.4", "100.2", "215.5"].entries()) {
    const last = shown?.parentElement?.children[i]?.lastChild;
    if (last) last.nodeValue = text;
  }
  const parts = "#dimensions, .drop, .drop > :not(input), .run, .view-head, .hand-panel > *, .decision, .head";
  return [...document.querySelectorAll(parts)]
    .filter((one) => one.checkVisibility())
    .filter((one) => {
      const own = one.getBoundingClientRect();
      const { left, right } = (one.closest(".panel, .run, .view") ?? document.body).getBoundingClientRect();
      return own.left < left - 0.5 || own.right > right + 0.5 || one.scrollWidth > one.clientWidth + 1;
    })
    .filter((one) => getComputedStyle(one).display !== "inline" || one.getBoundingClientRect().width > 0)
    .map((one) => `${one.id || one.className} ${one.scrollWidth} of ${one.clientWidth}`)
    .filter((text) => !text.endsWith("of 0"));
}

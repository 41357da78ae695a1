// Charts as SVG.

const make = (name, attributes, text) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

/**
 * A chart. `x` and `y` are { from, to, label, ticks }; `layers` draw into it, in order: { points | line, colour, size, name }.
 */
export function chart({ width, height, x, y, layers, notes = [] }) {
  const [left, right, top, bottom] = [y.label === "" ? 28 : 44, 16, 8, 34];
  const svg = make("svg", { width, height });
  const at = ([a, b]) => [
    left + ((a - x.from) / (x.to - x.from)) * (width - left - right),
    height - bottom - ((b - y.from) / (y.to - y.from)) * (height - top - bottom),
  ];
  const [[x0, y0], [x1, y1]] = [at([x.from, y.from]), at([x.to, y.to])];
  for (const [a, b] of [
    [x1, y0],
    [x0, y1],
  ])
    svg.append(make("line", { class: "axis", x1: x0, y1: y0, x2: a, y2: b }));
  for (const tick of x.ticks)
    svg.append(make("text", { x: at([tick, 0])[0], y: y0 + 14, "text-anchor": "middle" }, tick));
  for (const tick of y.ticks)
    svg.append(make("text", { x: x0 - 5, y: at([0, tick])[1] + 4, "text-anchor": "end" }, tick));
  svg.append(make("text", { x: (x0 + x1) / 2, y: height - 4, "text-anchor": "middle" }, x.label));
  const turn = `rotate(-90 11 ${(y0 + y1) / 2})`;
  svg.append(make("text", { x: 11, y: (y0 + y1) / 2, "text-anchor": "middle", transform: turn }, y.label));
  for (const { points, line, colour, size = 2, dashed = false } of layers) {
    for (const point of points ?? []) {
      const [cx, cy] = at(point).map((value) => value.toFixed(1));
      svg.append(make("circle", { cx, cy, r: size, fill: colour, "fill-opacity": 0.8 }));
    }
    if (line === undefined) continue;
    const path = line
      .map((point) =>
        at(point)
          .map((value) => value.toFixed(1))
          .join(" "),
      )
      .join(" L ");
    const dashes = dashed ? { "stroke-dasharray": "5 4" } : {};
    svg.append(make("path", { d: `M ${path}`, fill: "none", stroke: colour, "stroke-width": size, ...dashes }));
  }
  for (const { at: place, text, colour, anchor = "start" } of notes) {
    const [px, py] = at(place);
    const note = make(
      "text",
      { x: px, y: py, "text-anchor": anchor, style: `fill: ${colour}; font-weight: 600` },
      text,
    );
    svg.append(note);
  }
  return svg;
}

/** Bars of numbers from 0 to 1, each with its name and its value in words. */
export function bars({ width, rows, colour }) {
  const [label, value, line] = [118, 60, 23];
  const svg = make("svg", { width, height: rows.length * line });
  rows.forEach(({ name, share, text }, k) => {
    const [y, room] = [k * line, width - label - value];
    svg.append(make("text", { x: label - 6, y: y + 15, "text-anchor": "end" }, name));
    svg.append(make("rect", { x: label, y: y + 4, width: room, height: 14, fill: "#eee" }));
    const length = Math.max(0, Math.min(1, share)) * room;
    svg.append(make("rect", { x: label, y: y + 4, width: length.toFixed(1), height: 14, fill: colour }));
    svg.append(make("text", { x: width - value + 6, y: y + 15 }, text));
  });
  return svg;
}

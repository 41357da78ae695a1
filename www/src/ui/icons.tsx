/** Small pictograms, drawn because fonts lack them. */

const pictograms = {
  hidden: {
    title: "hidden",
    path: "M1 8s2.5-4.5 7-4.5S15 8 15 8s-2.5 4.5-7 4.5S1 8 1 8zM2.5 13.5l11-11",
  },
  locked: { title: "locked", path: "M3.5 7.5h9v6h-9zM5.5 7.5V5a2.5 2.5 0 0 1 5 0v2.5" },
} as const;

export function Icon({ name }: { name: keyof typeof pictograms }) {
  const { path, title } = pictograms[name];
  return (
    <svg class="icon" viewBox="0 0 16 16" width="16" height="16" role="img" aria-label={title}>
      <path d={path} fill="none" stroke="currentColor" stroke-width="1.4" stroke-linejoin="round" />
    </svg>
  );
}

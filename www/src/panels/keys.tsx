/** A key of a command, such as "Ctrl Shift Z" or "0 to 9". */

export const Keys = ({ title }: { title: string }) => (
  <span class="key">{title.split(" ").map((part) => (part === "to" ? " to " : <kbd key={part}>{part}</kbd>))}</span>
);

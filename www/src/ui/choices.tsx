/** One of several values, chosen from a list. */

interface ChoicesProps<V extends string> {
  id?: string;
  /** Where no label is beside it. */
  label?: string;
  value: V;
  choices: readonly (readonly [value: V, title: string])[];
  onChoose(value: V): void;
}

export function Choices<V extends string>({ id, label, value, choices, onChoose }: ChoicesProps<V>) {
  return (
    <select
      id={id}
      aria-label={label}
      value={value}
      onChange={({ currentTarget }) => onChoose(currentTarget.value as V)}
    >
      {choices.map(([value, title]) => (
        <option key={value} value={value}>
          {title}
        </option>
      ))}
    </select>
  );
}

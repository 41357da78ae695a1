/** What a build puts into the scripts of the page and of the element, in place of names that the sources declare. */

/**
 * @param {{ align: readonly { name: string, choices?: readonly string[], max?: number, default: unknown }[] }} options the option tables of the
 *   package: the scripts get only the rows and fields that they use
 * @param {string} samples the list of samples, JSON; as part of the script, it saves the page a request before those of the samples
 */
export function definitions({ align }, samples = "[]") {
  const rowOf = (/** @type {string} */ name) => align.find((row) => row.name === name);
  const defaults = Object.fromEntries(["quality", "symmetry", "seed"].map((name) => [name, rowOf(name)?.default]));
  const optionTable = { quality: rowOf("quality")?.choices, maxSeed: rowOf("seed")?.max, defaults };
  return { SAMPLES: samples, OPTION_TABLE: JSON.stringify(optionTable) };
}

/** Names in exported files: of files, bodies, meshes, prims and nodes. */

/**
 * Names that mean something else: to MuJoCo, PyBullet and USD, in the exported scenes, and as files on Windows. In small
 * letters.
 */
const RESERVED = /^(world|ground|camera|light|physics|scene|load|view|support|con|prn|aux|nul|(com|lpt)\d)$/;

/** Letters, digits and underscores, beginning with no digit: every format takes these. */
const identifier = (name: string): string => name.replace(/[^A-Za-z0-9]+/g, "_").replace(/^(?=\d|$)/, "_");

/** Gives each thing in the files of a scene a name of its own. Names that differ in case only are the same to some systems. */
export class Names {
  readonly #taken = new Set<string>();

  /** @param form converts any text to a name of the format */
  constructor(private readonly form: (name: string) => string = identifier) {}

  /** The wanted name in the form of the format, with a number after it if it is reserved or has been given before. */
  own(wanted: string): string {
    const plain = this.form(wanted);
    const isTaken = (name: string) => RESERVED.test(name) || this.#taken.has(name);
    let own = plain;
    for (let k = 2; isTaken(own.toLowerCase()); k++) own = `${plain}_${k}`;
    this.#taken.add(own.toLowerCase());
    return own;
  }
}

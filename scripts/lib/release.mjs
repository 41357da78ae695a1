/** Requirements of a release: a tag that names the version, a dated section of the changelog, a citation of both, and addresses. */

/** Placeholder for the owner of the repository in addresses. */
const PLACEHOLDER = "OWNER";

/**
 * The section of a version in the changelog, with its heading.
 * @param {string} changelog
 * @param {string} version
 */
const wholeSection = (changelog, version) =>
  changelog.split(/^(?=## \[)/m).find((text) => text.startsWith(`## [${version}]`));

/**
 * The section of a version in the changelog, without its heading.
 * @param {string} changelog
 * @param {string} version
 */
export function sectionOf(changelog, version) {
  const section = wholeSection(changelog, version);
  return section?.slice(section.indexOf("\n") + 1).trim();
}

/**
 * The notes of a release.
 * @param {string} tag such as v1.0.0
 * @param {Readonly<Record<string, unknown>> & { version: string }} manifest package.json of the package
 * @param {string} changelog
 * @param {string} citation what CITATION.cff says
 * @returns {string}
 * @throws with all that is missing
 */
export function releaseNotes(tag, manifest, changelog, citation) {
  const { version } = manifest;
  /** @type {string[]} */
  const missing = [];
  if (tag !== `v${version}`)
    missing.push(
      `The tag is ${tag}, the package has version ${version}. Remedy: tag v${version}, or raise the version.`,
    );
  const notes = sectionOf(changelog, version) ?? "";
  if (notes === "") missing.push(`CHANGELOG.md says nothing of ${version}. Remedy: write the section ## [${version}].`);
  if (sectionOf(changelog, "Unreleased"))
    missing.push(`CHANGELOG.md has unreleased changes. Remedy: move them to the section ## [${version}].`);
  const date = wholeSection(changelog, version)?.match(/^## .* - (\d{4}-\d\d-\d\d)$/m)?.[1];
  if (!date) missing.push(`CHANGELOG.md has no date of ${version}. Remedy: write ## [${version}] - YYYY-MM-DD.`);
  for (const line of [`version: ${version}`, ...(date ? [`date-released: ${date}`] : [])]) {
    if (!citation.split(/\r?\n/).includes(line))
      missing.push(`CITATION.cff does not say "${line}". Remedy: write it there.`);
  }
  for (const name of ["repository", "homepage", "bugs"]) {
    const address = JSON.stringify(manifest[name]) ?? "nothing";
    if (!address.includes("https://") || address.includes(PLACEHOLDER))
      missing.push(`${name} of pkg-config/package.json is ${address}. Remedy: write the address of the repository.`);
  }
  if (missing.length > 0) throw new Error(missing.join("\n"));
  return notes;
}

/**
 * The tag of npm under which a version is installed by default, or on request only.
 * @param {string} version
 */
export const distributionTag = (version) => (version.includes("-") ? "next" : "latest");

/** Requirements of a release: a tag that names the version, a dated section of the changelog, and a citation of both. */

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
 * @param {string} version of the package
 * @param {string} changelog
 * @param {string} citation what CITATION.cff says
 * @returns {string}
 * @throws if the tag names another version, or changelog or citation are not ready
 */
export function releaseNotes(tag, version, changelog, citation) {
  if (tag !== `v${version}`) {
    throw new Error(
      `The tag is ${tag}, the package has version ${version}. Remedy: tag v${version}, or raise the version.`,
    );
  }
  const notes = sectionOf(changelog, version);
  if (!notes) throw new Error(`CHANGELOG.md says nothing of ${version}. Remedy: write the section ## [${version}].`);
  const left = sectionOf(changelog, "Unreleased");
  if (left) {
    throw new Error(`CHANGELOG.md has unreleased changes. Remedy: move them to the section ## [${version}].`);
  }
  const date = wholeSection(changelog, version)?.match(/^## .* - (\d{4}-\d\d-\d\d)$/m)?.[1];
  if (!date) throw new Error(`CHANGELOG.md has no date of ${version}. Remedy: write ## [${version}] - YYYY-MM-DD.`);
  for (const line of [`version: ${version}`, `date-released: ${date}`]) {
    if (!citation.split(/\r?\n/).includes(line))
      throw new Error(`CITATION.cff does not say "${line}". Remedy: write it there.`);
  }
  return notes;
}

/**
 * The tag of npm under which a version is installed by default, or on request only.
 * @param {string} version
 */
export const distributionTag = (version) => (version.includes("-") ? "next" : "latest");

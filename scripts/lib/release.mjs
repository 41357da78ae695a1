/** What a release needs: a tag that names the version, and a section of the changelog. */

/**
 * The section of a version in the changelog, without its heading.
 * @param {string} changelog
 * @param {string} version
 * @returns {string | undefined}
 */
export function sectionOf(changelog, version) {
  const sections = changelog.split(/^(?=## \[)/m);
  const section = sections.find((text) => text.startsWith(`## [${version}]`));
  return section?.slice(section.indexOf("\n") + 1).trim();
}

/**
 * The notes of a release.
 * @param {string} tag such as v1.0.0
 * @param {string} version of the package
 * @param {string} changelog
 * @returns {string}
 * @throws if the tag names another version, or the changelog is not ready
 */
export function releaseNotes(tag, version, changelog) {
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
  return notes;
}

/**
 * The tag of npm under which a version is installed by default, or on request only.
 * @param {string} version
 */
export const distributionTag = (version) => (version.includes("-") ? "next" : "latest");

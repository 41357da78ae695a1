/** A Redis server's program for the tests: found, or installed where that is possible. */
import { installed } from "./system-package.mjs";

/** What to do where there is none. */
export const redisRemedy =
  "install Redis (Debian and Ubuntu: apt-get install redis-server), or name its server in REDIS_SERVER_PATH";

/**
 * Finds redis-server; installs it where there is none and this process may (Debian or Ubuntu, as root).
 * @returns {Promise<string | undefined>} its path
 */
export const redisServer = () =>
  installed({
    variable: "REDIS_SERVER_PATH",
    programs: ["redis-server"],
    elsewhere: ["/opt/homebrew/bin/redis-server", "/usr/local/bin/redis-server"],
    debianPackage: "redis-server",
  });

/**
 * Classes that copies of the package share: an app may load `sim3align/inline` beside the other entries, each with classes of
 * its own.
 */

const brandOf = (name: string) => Symbol.for(`sim3align.${name}`);

/** Whether an object is of the class with this name, of any copy of the package. Throws what a proxy throws. */
export const isBranded = (value: unknown, name: string): boolean =>
  Object(value) === value && brandOf(name) in (value as object);

/** Makes `instanceof` of a class accept the objects of every copy of the package. Classes that extend it keep their own. */
export function brand(type: abstract new (...args: never[]) => object, name: string): void {
  Object.defineProperty(type.prototype, brandOf(name), { value: true });
  Object.defineProperty(type, Symbol.hasInstance, {
    value(this: unknown, value: unknown): boolean {
      const isOfThis = () => Object.prototype.isPrototypeOf.call((this as typeof type).prototype, value as object);
      return isBranded(value, name) && (this === type || isOfThis());
    },
  });
}

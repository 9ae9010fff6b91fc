// Numbers as people read them.

/** A length that reads well: 3.2 mm, 14 cm, 1.5 m. */
export function length(metres: number): string {
  const size = Math.abs(metres);
  const [factor, unit] = size < 0.01 ? [1000, "mm"] : size < 1 ? [100, "cm"] : [1, "m"];
  return `${Number((metres * factor).toPrecision(2))} ${unit}`;
}

/** A length as `urdfcheck diff` writes it: 41 mm, 1.25 m. */
export function distance(metres: number): string {
  return metres < 1 ? `${Number((1000 * metres).toPrecision(3))} mm` : `${Number(metres.toPrecision(3))} m`;
}

/** An angle in degrees with a minus sign: −43.1°, 180°, 0.25°. */
export function angle(radians: number): string {
  const degrees = (radians * 180) / Math.PI;
  const size = Number(Math.abs(degrees).toFixed(Math.abs(degrees) < 1 ? 2 : 1));
  return `${degrees < 0 && size > 0 ? "\u2212" : ""}${size}°`;
}

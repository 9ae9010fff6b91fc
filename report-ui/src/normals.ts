// Normals that keep edges sharp and round surfaces smooth.

// Facets that meet at less than this are taken for one surface.
const SMOOTH = Math.cos((32 * Math.PI) / 180);

export interface Surface {
  points: Float32Array;
  /** Of length 127 each, as a normalised attribute of signed bytes. */
  normals: Int8Array;
  faces: Uint32Array;
}

/** Each corner is split into as many as there are smooth surfaces around it; its normals are weighted by area. */
export function creased(points: Float32Array, faces: Uint32Array): Surface {
  const corners = faces.length;
  const n = points.length / 3;
  const index = new Uint32Array(corners);
  // Split corner -> next one at the same point, the sum of its facets' normals, and the direction of its first facet.
  let room = Math.ceil(n * 1.5) + 64;
  let next = new Int32Array(room);
  let sums = new Float32Array(3 * room);
  let seeds = new Float32Array(3 * room);
  let origin = new Uint32Array(room);
  const first = new Int32Array(n).fill(-1);
  let count = 0;

  const grow = () => {
    room *= 2;
    const bigger = <T extends Float32Array | Int32Array | Uint32Array>(old: T, width: number): T => {
      const array = new (old.constructor as new (length: number) => T)(width * room);
      array.set(old);
      return array;
    };
    next = bigger(next, 1);
    origin = bigger(origin, 1);
    sums = bigger(sums, 3);
    seeds = bigger(seeds, 3);
  };

  for (let f = 0; f < corners; f += 3) {
    const a = 3 * faces[f];
    const b = 3 * faces[f + 1];
    const c = 3 * faces[f + 2];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const length = Math.sqrt(nx * nx + ny * ny + nz * nz) || 1;
    const dx = nx / length, dy = ny / length, dz = nz / length;
    for (let k = 0; k < 3; k++) {
      const point = faces[f + k];
      let slot = first[point];
      while (slot >= 0 && seeds[3 * slot] * dx + seeds[3 * slot + 1] * dy + seeds[3 * slot + 2] * dz < SMOOTH) {
        slot = next[slot];
      }
      if (slot < 0) {
        if (count === room) grow();
        slot = count++;
        origin[slot] = point;
        next[slot] = first[point];
        first[point] = slot;
        seeds[3 * slot] = dx;
        seeds[3 * slot + 1] = dy;
        seeds[3 * slot + 2] = dz;
      }
      sums[3 * slot] += nx;
      sums[3 * slot + 1] += ny;
      sums[3 * slot + 2] += nz;
      index[f + k] = slot;
    }
  }

  const split = new Float32Array(3 * count);
  // Four bytes each: what a graphics card likes to fetch.
  const normals = new Int8Array(4 * count);
  for (let i = 0; i < count; i++) {
    const from = 3 * origin[i];
    split[3 * i] = points[from];
    split[3 * i + 1] = points[from + 1];
    split[3 * i + 2] = points[from + 2];
    const x = sums[3 * i], y = sums[3 * i + 1], z = sums[3 * i + 2];
    const scale = 127 / (Math.sqrt(x * x + y * y + z * z) || 1);
    normals[4 * i] = x * scale;
    normals[4 * i + 1] = y * scale;
    normals[4 * i + 2] = z * scale;
  }
  return { points: split, normals, faces: index };
}

import assert from "node:assert/strict";
import { test } from "node:test";
import { BoxGeometry, Matrix4, Mesh } from "three";
import { load } from "./load.mjs";

const { unmatched } = await load("versions");

const cube = new BoxGeometry(1, 1, 1);

/** A body as `Robot` makes it, with the parts that a comparison looks at. */
function body(x, shape = { box: [1, 1, 1] }, at = new Matrix4()) {
  const mesh = new Mesh(cube);
  mesh.matrixWorld.copy(at).setPosition(x, 0, 0);
  return { shape: { color: null, ...shape }, mesh };
}

test("a body is the same where it is, and another one beside it", () => {
  const [here, there] = [body(0), body(0.041)];
  assert.deepEqual(unmatched([here], [body(0)]), new Set());
  assert.deepEqual(unmatched([here], [body(1e-5)]), new Set());
  assert.deepEqual(unmatched([here, there], [body(0)]), new Set([there]));
  assert.deepEqual(unmatched([here], []), new Set([here]));
});

test("a rotation, a colour, another mesh and another capsule are differences", () => {
  // A mesh in millimetres: the numbers of its matrix are small, its corners are not.
  const small = new Matrix4().makeScale(1e-3, 1e-3, 1e-3);
  const turned = new Matrix4().makeRotationZ(0.2).multiply(small);
  const mesh = { mesh: 0 };
  assert.equal(unmatched([body(0, mesh, small)], [body(0, mesh, turned)]).size, 1);
  assert.equal(unmatched([body(0, mesh)], [body(0, { mesh: 1 })]).size, 1);
  assert.equal(unmatched([body(0)], [body(0, { box: [1, 1, 1], color: [1, 0, 0, 1] })]).size, 1);
  assert.equal(unmatched([body(0, { capsule: [1, 2] })], [body(0, { capsule: [1, 3] })]).size, 1);
  // Boxes of two sizes are the same unit cube in two matrices.
  assert.equal(unmatched([body(0, { box: [1, 2, 3] })], [body(0, { box: [1, 1, 1] })]).size, 0);
});

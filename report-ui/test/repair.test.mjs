import assert from "node:assert/strict";
import { test } from "node:test";
import { Matrix4, Vector3 } from "three";
import { load } from "./load.mjs";

const { turnOf } = await load("repair");
const { explain } = await load("legend");
const { angle, distance, length } = await load("words");

const turned = (axis, degrees) => new Matrix4().makeRotationAxis(new Vector3(...axis).normalize(), (degrees * Math.PI) / 180);
const degrees = (turn) => (turn.angle * 180) / Math.PI;

test("a rotation about the joint's axis has the sign of that axis", () => {
  const repaired = turned([1, 2, 3], 70).setPosition(4, 5, 6);
  for (const wanted of [-43.11, 43.11, 179, -179, 0.02]) {
    const now = repaired.clone().multiply(turned([0, 1, 0], wanted)).setPosition(1, 2, 3);
    assert.ok(Math.abs(degrees(turnOf(repaired, now, [0, 1, 0])) - wanted) < 1e-4, String(wanted));
    assert.ok(Math.abs(degrees(turnOf(repaired, now, [0, -2, 0])) + wanted) < 1e-4, String(wanted));
  }
});

test("a rotation about another axis, or of a joint without one, is positive", () => {
  for (const axis of [[1, 0, 0], null]) {
    const turn = turnOf(new Matrix4(), turned([0, 0, 1], -90), axis);
    assert.ok(Math.abs(degrees(turn) - 90) < 1e-6);
    assert.ok(turn.axis.distanceTo(new Vector3(0, 0, -1)) < 1e-6);
  }
  assert.equal(turnOf(turned([0, 0, 1], 30), turned([0, 0, 1], 30), [0, 0, 1]).angle, 0);
});

test("numbers read well", () => {
  assert.equal(angle((-43.113 * Math.PI) / 180), "\u221243.1°");
  assert.equal(angle(Math.PI), "180°");
  assert.equal(angle(-1e-6), "0°");
  assert.equal(length(0.0032), "3.2 mm");
  assert.equal(length(1.5), "1.5 m");
  assert.equal(distance(0.1044), "104 mm");
  assert.equal(distance(1.2519), "1.25 m");
});

test("the legend names what is drawn, and nothing else", () => {
  const none = { isAfter: false, line: "other", turns: false, frames: new Set(), inertias: new Set(), broken: false };
  const said = (marks) => explain({ layers: new Set(), lines: new Set(), broken: false, versions: false, repair: none, ...marks }).map(([kind]) => kind);
  assert.deepEqual(said({}), []);
  assert.deepEqual(said({ layers: new Set(["visual", "com"]), lines: new Set(["error", "warning"]) }), ["line error", "line warning", "com"]);
  assert.deepEqual(said({ broken: true }), ["broken"]);
  assert.deepEqual(said({ lines: new Set(["warning", "other"]), versions: true }), ["line warning", "line other"]);
  const inertia = { ...none, inertias: new Set(["arm"]) };
  assert.deepEqual(said({ repair: inertia }), ["shown before", "dashed after"]);
  assert.deepEqual(said({ repair: { ...inertia, isAfter: true } }), ["shown after", "dashed before"]);
  assert.deepEqual(said({ repair: { ...inertia, broken: true } }), ["dashed after", "broken"]);
  assert.deepEqual(said({ repair: { ...inertia, broken: true, isAfter: true } }), ["shown after"]);
  const joint = { ...none, frames: new Set(["wheel"]), turns: true };
  assert.deepEqual(said({ lines: new Set(["other"]), repair: joint }), ["line other", "turn", "frames"]);
  const after = { ...joint, isAfter: true, line: "warning" };
  assert.deepEqual(said({ lines: new Set(["warning"]), repair: after }), ["line warning", "turn", "frames"]);
});

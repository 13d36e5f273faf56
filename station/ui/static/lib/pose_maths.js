// Poses [x, y, z, qx, qy, qz, qw] and what people type of them; needs no page.
// Roll, pitch and yaw turn about the fixed axes x, y and z, one after the other.

/** Return the product of two quaternions: first the second turn, then the first. */
export function product([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

/** Return a vector turned by a quaternion. */
export function turned(vector, [x, y, z, w]) {
  const [tx, ty, tz] = product(product([x, y, z, w], [...vector, 0]), [-x, -y, -z, w]);
  return [tx, ty, tz];
}

/** Return the quaternion of a turn by an angle [rad] about an axis: 0, 1 or 2. */
export function about(axis, angle) {
  const quaternion = [0, 0, 0, Math.cos(angle / 2)];
  quaternion[axis] = Math.sin(angle / 2);
  return quaternion;
}

/** Return the quaternion of roll, pitch and yaw [rad]. */
export function fromAngles([roll, pitch, yaw]) {
  return product(about(2, yaw), product(about(1, pitch), about(0, roll)));
}

/** Return roll, pitch and yaw [rad] of a quaternion; at a pitch of ±90° all of the turn is yaw. */
export function toAngles([x, y, z, w]) {
  const columns = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0, 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0];
  return anglesOfMatrix([...columns, 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]);
}

/**
 * Return a pose one step further: `size` [m] along the axis 0, 1 or 2, or [rad] about the
 * axis 3, 4 or 5, of the base or of the end effector.
 */
export function stepped(pose, axis, size, isOfTool) {
  const place = pose.slice(0, 3);
  const quaternion = pose.slice(3);
  if (axis >= 3) {
    const turn = about(axis - 3, size);
    const [first, second] = isOfTool ? [quaternion, turn] : [turn, quaternion];
    const next = product(first, second);
    const length = Math.hypot(...next); // many steps must not add up their rounding
    return [...place, ...next.map((part) => part / length)];
  }
  const along = [0, 1, 2].map((i) => (i === axis ? size : 0));
  const way = isOfTool ? turned(along, quaternion) : along;
  return [...place.map((value, i) => value + way[i]), ...quaternion];
}

/** Return roll, pitch and yaw [rad] of a matrix of 16 numbers, column by column, as `O_T_EE`. */
export function anglesOfMatrix(m) {
  const sine = Math.max(-1, Math.min(-m[2], 1));
  if (Math.abs(sine) > 1 - 1e-9) return [0, (Math.sign(sine) * Math.PI) / 2, Math.atan2(-m[4], m[5])];
  return [Math.atan2(m[6], m[10]), Math.asin(sine), Math.atan2(m[1], m[0])];
}

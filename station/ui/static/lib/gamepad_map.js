// How far a gamepad asks a hand to move in each direction; needs no page.

const DEAD_ZONE = 0.12; // of a stick that nobody touches

/** Return -1 to 1 for along x, y, z and about x, y, z, as the standard mapping of browsers has sticks and buttons. */
export function directionsOf({ axes, buttons }) {
  const stick = (i) => {
    const size = Math.min((Math.abs(axes[i] ?? 0) - DEAD_ZONE) / (1 - DEAD_ZONE), 1);
    // Squared: small deflections are for exact motion.
    return size > 0 ? Math.sign(axes[i]) * size * size : 0;
  };
  const pair = (plus, minus) => Number(Boolean(buttons[plus]?.pressed)) - Number(Boolean(buttons[minus]?.pressed));
  return [-stick(1), -stick(0), -stick(3), pair(15, 14), pair(12, 13), -stick(2)].map((size) => size || 0);
}

// A second, translucent robot in the 3D view of this session: a recorded or planned pose.
// It is a picture and moves nothing.
import { send } from "./station.js";

const EVERY_MS = 50;

/** Call `step` with the seconds since now, again and again until it returns false; returns what ends it. */
export function ticking(step) {
  const began = performance.now();
  const tick = () => step((performance.now() - began) / 1000) === false && clearInterval(timer);
  const timer = setInterval(tick, EVERY_MS);
  tick();
  return () => clearInterval(timer);
}

let wanted = null; // {method, body}: the newest that was asked for and is not sent yet
let sending = false;

async function ask(method, body) {
  wanted = { method, body };
  if (sending) return;
  sending = true;
  while (wanted) {
    const newest = wanted;
    wanted = null;
    // A picture that fails is no reason to interrupt a person; the next one may work.
    await send(newest.method, "/ui/ghost", newest.body).catch((error) => console.warn(error.message));
    await new Promise((resolve) => setTimeout(resolve, EVERY_MS));
  }
  sending = false;
}

/** Show these joint positions, {joint: rad or m}; of quick calls the newest is sent. */
export const showGhost = (positions, label = "") => void ask("POST", { positions, label });

export const hideGhost = () => void ask("DELETE");

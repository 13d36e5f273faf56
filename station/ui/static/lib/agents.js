// What agents ask for: who, what, with what, and a person's answer. It lies over the picture,
// so that it moves nothing below the pointer.
import { act, follow, html, nothing, peek, press, render, repeat, store } from "./panel.js";
import { Forecast, stepOf } from "./forecast.js";

const TICK_MS = 1000;
const ANSWERS = [
  ["allowed", "Allow", "Let the station do this now."],
  ["allowed_for_a_time", "Allow for 10 minutes", "Let it do this, and all that this agent asks for in the next 10 minutes. It ends early when anybody stops the robot or takes control."],
  ["refused", "Refuse", "Nothing is done; the agent is told."],
];

let waiting = [];
const forecasts = new Map(); // by the numbers of the requests

/** Return what the request would do, tried as soon as it is seen; nothing of what moves nothing. */
function forecastOf(asked) {
  const hasTwin = store.docks?.simulation || store.docks?.arms.length; // a copy of the station, or a model of a real arm
  const step = hasTwin && store.isOperator ? stepOf(asked) : null;
  if (!step) return nothing;
  if (!forecasts.has(asked.number)) {
    forecasts.set(asked.number, new Forecast());
    forecasts.get(asked.number).rehearse([step], { isOfOther: true });
  }
  return forecasts.get(asked.number).element;
}

function card(asked) {
  const { operation, target, request } = asked;
  const what = operation.replaceAll("_", " ") + (target ? `: ${target}` : "");
  const content = Object.keys(request ?? {}).length ? JSON.stringify(request, null, 1) : "";
  const left = Math.max(0, Math.round(asked.expires_at - Date.now() / 1e3));
  const answer = (verdict) => act("POST", `/agents/requests/${asked.number}`, { verdict }).then(look);
  return html`<section class="request" aria-label="Request of ${asked.agent}">
    <p><b>${asked.agent}</b> asks for <b>${what}</b> <small>refused in ${left} s</small></p>
    ${content ? html`<details><summary>With</summary><pre>${content}</pre></details>` : ""}
    ${forecastOf(asked)}
    <div class="line">
      ${ANSWERS.map(([verdict, text, why]) => press(text, why, () => answer(verdict), { off: !store.isOperator }))}
    </div>
  </section>`;
}

function draw() {
  waiting = waiting.filter((one) => one.expires_at * 1e3 > Date.now());
  for (const [number, forecast] of forecasts) {
    if (waiting.some((one) => one.number === number)) continue;
    forecast.close();
    forecasts.delete(number);
  }
  const place = document.getElementById("agents");
  place.hidden = !waiting.length;
  render(html`${repeat(waiting, ({ number }) => number, card)}`, place);
}

async function look() {
  const answer = await peek("/agents/requests");
  if (!answer) return;
  waiting = answer.requests.filter(({ verdict }) => verdict === null);
  draw();
}

/** Begin to show what agents ask for. */
export function watchAgents() {
  follow("events", "rate=10", (frame) => frame.data.kind === "agent" && look());
  setInterval(() => waiting.length && draw(), TICK_MS);
  look();
}

// Says why a login was refused, and skips the form for who is logged in already
// (a link from another site does not bring the cookie, this request does).
"use strict";

const REFUSALS = {
  token: "That is not a token of this station. Every start of the station makes a new one.",
  link: "The station does not answer, so the token cannot be checked. Is it running?",
};

// Asked here once: whoever takes control, or has lessons checked, has this name.
const person = document.getElementById("person");
try {
  person.value = JSON.parse(localStorage.getItem("station.person") ?? '""');
  person.addEventListener("input", () => localStorage.setItem("station.person", JSON.stringify(person.value.trim())));
} catch {
  // A browser that keeps nothing asks again.
}
(person.value ? document.getElementById("token") : person).focus();

const reason = new URLSearchParams(location.search).get("refused");
if (reason in REFUSALS) {
  const line = document.getElementById("refusal");
  line.textContent = REFUSALS[reason];
  line.hidden = false;
}

fetch("/login", { method: "HEAD", redirect: "manual" }).then((answer) => {
  if (answer.type === "opaqueredirect") location.replace("/");
});

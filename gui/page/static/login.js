// A QR code contains the word after `#`, which browsers send to no server: type it, and log in.
function enter() {
  const word = decodeURIComponent(location.hash.slice(1));
  if (!word) return;
  history.replaceState(null, "", location.pathname);
  document.getElementById("typed").value = word;
  document.querySelector("form").requestSubmit();
}

addEventListener("hashchange", enter);
if (!document.querySelector(".refusal")) enter();

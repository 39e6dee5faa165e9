// A QR code contains the word after `#`, which browsers send to no server: type it, and log in.
const word = decodeURIComponent(location.hash.slice(1));
const refused = document.querySelector(".refusal");
if (word) history.replaceState(null, "", location.pathname);
if (word && !refused) {
  document.getElementById("typed").value = word;
  document.querySelector("form").requestSubmit();
}

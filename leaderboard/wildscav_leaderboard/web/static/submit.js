// Sends the archive that is chosen in the form as the body of one request, and shows how far it is.

const form = document.querySelector("form[data-submit]");
const status = document.querySelector("#upload-status");
const suffixes = form.dataset.suffixes.split(" ");

form.addEventListener("submit", (event) => {
  event.preventDefault();
  const file = form.elements.archive.files[0];
  const suffix = suffixes.find((one) => file && file.name.toLowerCase().endsWith(one));
  if (!suffix) {
    status.textContent = `Choose an archive: ${suffixes.join(", ")}.`;
    return;
  }
  const query = new URLSearchParams({ message: form.elements.message.value, suffix });
  if (form.elements.replaces?.value) query.set("replaces", form.elements.replaces.value);
  const request = new XMLHttpRequest();
  request.open("POST", `/submit?${query}`);
  request.setRequestHeader("X-CSRF", form.elements.csrf.value);
  request.responseType = "json";
  request.upload.onprogress = ({ loaded, total }) => {
    status.textContent = loaded < total ? `${Math.floor((100 * loaded) / total)} % sent` : "checking the archive…";
  };
  request.onload = () => {
    if (request.status === 201) location.assign(request.response.address);
    else status.textContent = request.response?.error ?? "The server did not understand: try again.";
  };
  request.onerror = () => (status.textContent = "The connection was lost: nothing was submitted.");
  request.send(file);
});

const box = document.querySelector(".search");
const field = box.querySelector("input"), told = box.querySelector("output");
const rows = [...document.querySelectorAll(".generation")];
box.hidden = false;
field.addEventListener("input", () => {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  let found = 0;
  for (const row of rows) {
    let any = false;
    for (const card of row.querySelectorAll(".landscape")) {
      const name = card.querySelector("h3").textContent.toLowerCase();
      const match = words.every(word => name.includes(word));
      card.classList.toggle("no-match", !match);
      any ||= match;
      found += match;
    }
    row.hidden = !any;
    row.style.display = any ? "" : "none";
  }
  told.textContent = words.length ? `${found} found` : "";
});

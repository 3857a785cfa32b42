(function () {
  "use strict";
  var box = document.getElementById("zoom");
  var large = box.querySelector("img");
  var title = box.querySelector("p");
  var row = [];
  var at = 0;
  function show(i) {
    at = (i + row.length) % row.length;
    large.src = row[at].dataset.own;
    title.textContent = row[at].alt;
  }
  function open(img) {
    row = Array.from(img.closest(".pictures").querySelectorAll("img"));
    show(row.indexOf(img));
    box.showModal();
  }
  document.querySelectorAll("figure img").forEach(function (img) {
    img.dataset.own = img.src;
    var figure = img.closest("figure");
    var name = figure.querySelector("em");
    var own = name.textContent;
    var other = document.getElementById(img.dataset.flip);
    function flip(on) {
      if (!other) { return; }
      img.src = on ? other.dataset.own : img.dataset.own;
      name.textContent = on ? other.closest("figure").querySelector("em").dataset.name : own;
      figure.classList.toggle("flipped", on);
    }
    name.dataset.name = own;
    img.addEventListener("mouseenter", function () { flip(true); });
    img.addEventListener("mouseleave", function () { flip(false); });
    img.addEventListener("click", function () { flip(false); open(img); });
    img.addEventListener("keydown", function (event) { if (event.key === "Enter") { open(img); } });
  });
  large.addEventListener("click", function () { show(at + 1); });
  box.addEventListener("click", function (event) { if (event.target === box) { box.close(); } });
  box.addEventListener("keydown", function (event) {
    if (event.key === "ArrowRight" || event.key === " ") { show(at + 1); event.preventDefault(); }
    if (event.key === "ArrowLeft") { show(at - 1); event.preventDefault(); }
  });
}());

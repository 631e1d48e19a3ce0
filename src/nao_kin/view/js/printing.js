// Paper: a canvas may come out blank, so a picture of it is printed instead.

function preparePrinting(viewer, pane) {
  let picture = null;
  const before = () => {
    if (picture) return;
    viewer.render();
    picture = el("img", { id: "paper", alt: pane.getAttribute("aria-label"), src: viewer.renderer.domElement.toDataURL() });
    pane.append(picture);
  };
  const after = () => {
    if (picture) picture.remove();
    picture = null;
  };
  window.addEventListener("beforeprint", before);
  window.addEventListener("afterprint", after);
}

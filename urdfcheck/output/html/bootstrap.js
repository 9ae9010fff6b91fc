"use strict";
// Unpacks the 3D view and runs it as one more inline script, which the page's policy knows by its hash.
(async () => {
  try {
    const packed = atob(document.getElementById("uc-app").textContent.trim());
    const bytes = Uint8Array.from(packed, (letter) => letter.charCodeAt(0));
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    const script = document.createElement("script");
    script.textContent = await new Response(plain).text();
    document.body.append(script);
  } catch (error) {
    document.body.dataset.error = error.message;
    document.getElementById("no-viewer").textContent = `The robot cannot be shown in 3D: ${error.message}.`;
  }
})();

// The examples name the address under which this page was found.
for (const at of document.querySelectorAll(".at")) at.textContent = location.origin;

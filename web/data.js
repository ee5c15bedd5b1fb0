// The page's data blocks; see README.md.

// The block with this id, or undefined.
export function readData(id) {
  const element = document.getElementById(id);
  return element ? JSON.parse(element.textContent) : undefined;
}

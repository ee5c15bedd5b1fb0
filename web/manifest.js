// The command that makes the page again ends with the page's own name, which the program leaves open: the bytes of the page do
// not depend on it.

const quote = (text) => (/^[A-Za-z0-9_./+:@%,-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

export function nameOwnFile(element) {
  const name = decodeURIComponent(location.pathname.split("/").pop() ?? "");
  const output = element?.querySelector(".output");
  if (output && /\.html?$/i.test(name)) output.textContent = quote(name.startsWith("-") ? `./${name}` : name);
}

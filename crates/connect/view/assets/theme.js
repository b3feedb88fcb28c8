// Dark or light: as the system says, until a person chooses.
const Theme = (() => {
  const button = byId('theme'), system = window.matchMedia('(prefers-color-scheme: dark)');
  const isDark = () => (document.documentElement.dataset.theme || (system.matches ? 'dark' : 'light')) === 'dark';
  const show = () => { button.setAttribute('aria-pressed', String(isDark())); Scene.stage.theme(); };
  function toggle() {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    show();
  }
  button.addEventListener('click', toggle);
  system.addEventListener('change', show);
  show();
  return { toggle };
})();

// Colours that WebGL and canvas draw; those of panels are in replay.css.
export const stage_colors = {physics: '#8a6fd1', resolution: '#d0679d', assembly: '#c79a1e', solve: '#3d83d0', collision: '#2aa08f', other: '#8f98a3'};
export const mark_colors = {wrong: '#e0142f', stuck: '#e0142f', held: '#ef7d1a', behind: '#8a6fd1', returned: '#8a6fd1', untracked: '#8f98a3'};
// By Frame::origin: free, constrained, damped, bounded, relaxed, held, limited.
export const origins = ['free', 'constrained', 'damped', 'bounded', 'relaxed', 'held', 'limited'];
export const origin_colors = ['#8f98a355', '#3d83d0', '#2aa08f', '#c79a1e', '#d0679d', '#ef7d1a', '#a03fb8'];
export const contact_colors = {near: 0x7fae9c, push: 0x0d9a58, inside: 0xe0142f};

export const themes = {
  light: {
    floor: 0xd5dae1, grid: 0x9aa5b3, grid_strength: .55, shadow: .2, sky: 0xffffff, earth: 0xb4b9c2, hemisphere: 1.75, sun: 1.9, fill: .55,
    fixed: [0xc9cdd3, 0xbdc4cc, 0xd2d0cb, 0xb9bfc4, 0xc8c6ce], loose: [0x9dbf9f, 0xd9b48f, 0x9fb6d4, 0xd3a5a9, 0xb8b0d6, 0xc9c58d],
    hands: [[0x2f78c8, 0x285f9e], [0x7b62c9, 0x634d9f]], touch: [0x4fb0e6, 0x9b86e6], ghost: 0xe8890c,
  },
  dark: {
    floor: 0x12161c, grid: 0x46505e, grid_strength: .6, shadow: .5, sky: 0xdfe9f7, earth: 0x2a2f38, hemisphere: 1.15, sun: 2.1, fill: .45,
    fixed: [0x6b737e, 0x5d6671, 0x77746e, 0x5a6168, 0x6c6977], loose: [0x6f9a73, 0xb08a62, 0x6f8cb4, 0xb27b81, 0x8b81b3, 0xa09b5c],
    hands: [[0x4b9bec, 0x3b7dc2], [0x957df0, 0x7862c6]], touch: [0x7fd0ff, 0xb9a8ff], ghost: 0xffb042,
  },
};

"""Dear ImGui in a window: its events go in, its triangles come out."""

import ctypes
from pathlib import Path

import imgui_bundle
import moderngl
from imgui_bundle import imgui
from moderngl_window.context.base import BaseWindow
from moderngl_window.integrations.imgui_bundle import ModernGLRenderer

_FONT = Path(imgui_bundle.__file__).parent / "assets" / "fonts" / "Roboto" / "Roboto-Regular.ttf"
_FONT_SIZE = 16.0
_KEYS = {name: getattr(imgui.Key, name) for name in ("backspace", "delete", "enter", "escape", "home", "end", "tab")}


class Interface(ModernGLRenderer):
    """moderngl-window's renderer, with the textures of Dear ImGui 1.92: it makes and updates them as glyphs come up."""

    def __init__(self, window: BaseWindow) -> None:
        """Set up Dear ImGui for `window`."""
        imgui.create_context()
        io = imgui.get_io()
        io.set_ini_filename("")
        if _FONT.is_file():
            io.fonts.add_font_from_file_ttf(str(_FONT), _FONT_SIZE)
        self._window = window
        super().__init__(ctx=window.ctx)

    def refresh_font_texture(self) -> None:
        """Promise to make textures when they are asked for."""
        self.io.backend_flags |= imgui.BackendFlags_.renderer_has_textures

    @property
    def wants_mouse(self) -> bool:
        """Whether the cursor is over a panel, or drags something in one."""
        return self.io.want_capture_mouse

    @property
    def wants_text(self) -> bool:
        """Whether a person types into a field."""
        return self.io.want_text_input

    def point(self, x: float, y: float) -> None:
        """The cursor is there."""
        self.io.add_mouse_pos_event(x, y)

    def click(self, button: int, down: bool) -> None:
        """A mouse button, as moderngl-window counts from 1, goes down or up."""
        self.io.add_mouse_button_event(button - 1, down)

    def scroll(self, x: float, y: float) -> None:
        """The wheel turns."""
        self.io.add_mouse_wheel_event(x, y)

    def press(self, key: str, down: bool) -> None:
        """A key, by its name in `keys`, goes down or up."""
        if key in _KEYS:
            self.io.add_key_event(_KEYS[key], down)

    def type(self, text: str) -> None:
        """Text is typed."""
        self.io.add_input_characters_utf8(text)

    def begin(self, seconds: float) -> None:
        """Begin a frame, `seconds` after the one before."""
        width, height = self._window.size
        self.io.display_size = imgui.ImVec2(width, height)
        self.io.display_framebuffer_scale = imgui.ImVec2(*[self._window.pixel_ratio] * 2)
        self.io.delta_time = max(seconds, 1e-4)
        imgui.new_frame()

    def end(self) -> None:
        """Draw what was asked for since `begin` into the bound framebuffer."""
        imgui.render()
        self.render(imgui.get_draw_data())

    def render(self, draw_data: imgui.ImDrawData) -> None:
        """Draw triangles, list by list."""
        for texture in draw_data.textures:
            self._keep(texture)
        width, height = self.io.display_size
        pixels = self._window.buffer_size
        if 0 in pixels:
            return
        self.projMat.value = (2 / width, 0, 0, 0, 0, -2 / height, 0, 0, 0, 0, -1, 0, -1, 1, 0, 1)
        draw_data.scale_clip_rects(self.io.display_framebuffer_scale)
        self.ctx.enable_only(moderngl.BLEND)
        self.ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        for commands in draw_data.cmd_lists:
            self._draw(commands, pixels[1])
        self.ctx.scissor = None

    def _draw(self, commands: imgui.ImDrawList, height: int) -> None:
        self._fill("_vertex_buffer", commands.vtx_buffer, imgui.VERTEX_SIZE)
        self._fill("_index_buffer", commands.idx_buffer, imgui.INDEX_SIZE)
        for command in commands.cmd_buffer:
            self._textures[command.get_tex_id()].use(0)
            left, top, right, bottom = command.clip_rect
            self.ctx.scissor = int(left), int(height - bottom), int(right - left), int(bottom - top)
            self._vao.render(moderngl.TRIANGLES, vertices=command.elem_count, first=command.idx_offset)

    def _fill(self, name: str, array, size: int) -> None:
        getattr(self, name).write((ctypes.c_byte * (array.size() * size)).from_address(array.data_address()))

    def _keep(self, wanted: imgui.ImTextureData) -> None:
        """Do to a texture what its status asks for."""
        status = imgui.ImTextureStatus
        size = (wanted.width, wanted.height)
        if wanted.status == status.want_create:
            texture = self.ctx.texture(size, 4, wanted.get_pixels_array().tobytes())
            self.register_texture(texture)
            wanted.set_tex_id(texture.glo)
            wanted.set_status(status.ok)
        elif wanted.status == status.want_updates:
            self._textures[wanted.tex_id].write(wanted.get_pixels_array().tobytes())
            wanted.set_status(status.ok)
        elif wanted.status == status.want_destroy and wanted.unused_frames > 0:
            self._textures.pop(wanted.tex_id).release()
            wanted.set_tex_id(0)
            wanted.set_status(status.destroyed)

"""Nothing that is drawn is lost: drafts of the browser, and the file on the disk."""

import socket
import time

import pytest
from drawing import STUDIO, link_to
from serving import Server, until


def rod(sheet, at=(0.2, 0.1)):
    sheet.tool("link")
    sheet.click((0, 0), ground=True)
    sheet.click(at)


@pytest.mark.smoke
def test_a_reload_at_once_keeps_the_last_gesture_and_its_undo(sheet):
    empty = sheet.text
    rod(sheet)
    first = sheet.text
    sheet.tool("pivot")
    sheet.click((0.2, 0.1))
    last = sheet.text
    sheet.reload()
    assert sheet.text == last
    for text in (first, empty):
        sheet.page.keyboard.press("Control+z")
        assert sheet.text == text
    sheet.reload()
    assert sheet.text == empty
    for text in (first, last):
        sheet.page.keyboard.press("Control+y")
        assert sheet.text == text


def test_typed_text_counts_as_soon_as_it_is_typed(sheet):
    rod(sheet)
    sheet.page.locator(".editor .cm-content").click()
    sheet.page.keyboard.press("Control+End")
    sheet.page.keyboard.type("# last word\noops")
    sheet.reload()
    assert sheet.text.endswith("# last word\noops")
    sheet.page.keyboard.press("Control+z")
    assert "oops" not in sheet.text
    # A number in a field counts, too, while the caret is still in it.
    sheet.tool("select")
    sheet.click((0.1, 0.05))
    sheet.page.locator(".inspector .field", has_text="B x").locator("input").fill("300")
    sheet.reload()
    assert sheet.file["bodies"]["link"]["markers"]["B"][0] == 0.3


@pytest.mark.smoke
def test_links_tabs_new_sheets_and_templates_overwrite_no_draft(sheet, tab):
    rod(sheet)
    mine = sheet.text
    other = tab(sheet.index.as_uri() + link_to(mine.replace("mechanism", "friend")))
    assert 'name = "friend"' in other.text
    other.tool("pivot")
    other.click((0.2, 0.1))
    friends = other.text
    other.reload()
    assert other.text == friends
    assert sheet.text == mine
    assert sorted(sheet.drafts) == sorted([mine, friends])
    # A new sheet and a template ask nothing and lose nothing.
    other.menu("New")
    assert "friend" not in other.text
    other.open_template("four_bar")
    template = other.text
    other.reload()
    assert other.text == template
    assert sorted(sheet.drafts) == sorted([mine, friends])
    # Two tabs with one draft: the one that is changed later goes on by itself.
    third = tab()
    assert third.text == friends
    sheet.tool("pivot")
    sheet.click((0.2, 0.1))
    sheet.reload()
    assert sheet.text != mine
    # A draft comes back from the list, with its undo.
    third.menu("Drafts")
    third.page.locator(".draft button", has_text="mechanism").first.click()
    third.page.wait_for_selector("dialog", state="detached")
    third.frame()
    assert third.text == sheet.text
    third.page.keyboard.press("Control+z")
    assert third.text == mine
    sheet.page.bring_to_front()
    sheet.tool("link")
    sheet.click((0.05, 0.08), (0.1, 0.1))
    assert "another tab" in sheet.said.lower()
    third.reload()
    assert third.text == mine
    sheet.reload()
    assert len(sheet.file["bodies"]) == 2


def test_a_link_put_into_an_open_studio_is_opened_and_a_cut_one_says_so(sheet):
    rod(sheet)
    link = link_to(sheet.text.replace("mechanism", "friend"))
    sheet.page.evaluate("(link) => { location.hash = link; }", link)
    sheet.page.wait_for_function(f"() => {STUDIO}.text.includes('friend')")
    sheet.page.evaluate("(link) => { location.hash = link.slice(0, -9); }", link)
    sheet.page.wait_for_function("() => !location.hash")
    assert "link is not whole" in sheet.said
    assert "friend" in sheet.text


@pytest.mark.smoke
def test_a_store_that_takes_nothing_is_told_until_it_is_saved(sheet):
    sheet.page.evaluate(
        """() => { Storage.prototype.setItem = () => { throw new DOMException("full", "QuotaExceededError"); }; }"""
    )
    rod(sheet)
    told = sheet.page.locator(".unsaved")
    assert "is full" in told.inner_text()
    asked = []
    sheet.page.once("dialog", lambda dialog: (asked.append(dialog.type), dialog.dismiss()))
    sheet.page.close(run_before_unload=True)
    sheet.page.wait_for_function("() => true")
    assert asked == ["beforeunload"]
    sheet.menu("New")
    sheet.page.locator("dialog button.primary").click()
    assert sheet.file["bodies"]
    with sheet.page.expect_download():
        sheet.page.keyboard.press("Control+s")
    assert not told.is_visible()


@pytest.mark.smoke
def test_edits_wait_while_the_server_is_gone(served):
    sheet, server, file = served
    rod(sheet)
    until(lambda: file.exists() and file.read_text() == sheet.text)
    server.stop()
    sheet.tool("pivot")
    sheet.click((0.2, 0.1))
    told = sheet.page.locator(".unsaved")
    told.wait_for()
    assert "does not answer" in told.inner_text()
    assert file.read_text() != sheet.text
    server.start()
    until(lambda: file.read_text() == sheet.text)
    told.wait_for(state="hidden")
    # Gone with its page: the next one goes on with what was drawn.
    server.stop()
    sheet.page.keyboard.press("Control+z")
    text = sheet.text
    sheet.page.once("dialog", lambda dialog: dialog.accept())
    sheet.page.goto("about:blank")
    server.start()
    sheet.page.goto(server.address)
    sheet.page.wait_for_selector(".studio.ready")
    assert sheet.text == text
    until(lambda: file.read_text() == text)
    sheet.page.keyboard.press("Control+y")
    assert sheet.text != text


def test_a_file_that_another_program_changes_is_not_written_over(served):
    sheet, _, file = served
    rod(sheet)
    until(lambda: file.exists() and file.read_text() == sheet.text)
    changed = sheet.text.replace("rod", "pole")
    file.write_text(changed)
    sheet.tool("pivot")
    sheet.click((0.2, 0.1))
    mine = sheet.text
    sheet.page.locator(".unsaved .from-disk").wait_for()
    assert file.read_text() == changed
    sheet.page.locator(".unsaved .from-disk").click()
    sheet.page.wait_for_function(f"() => {STUDIO}.text.includes('pole')")
    assert mine in sheet.drafts
    file.write_text(changed.replace("pole", "mast"))
    sheet.tool("pivot")
    sheet.click((0.2, 0.1))
    sheet.page.locator(".unsaved .to-disk").click()
    until(lambda: file.read_text() == sheet.text)
    assert "pole" in sheet.text
    # Another drawing leaves the file alone.
    before = file.read_text()
    sheet.menu("New")
    rod(sheet, (0.1, 0.3))
    time.sleep(0.2)
    assert file.read_text() == before
    sheet.menu("Back to rod.toml")
    assert sheet.text == before


def test_tabs_that_begin_with_one_unchanged_file_keep_both_drawings(served, tab):
    sheet, server, file = served
    other = tab(server.address)
    rod(sheet)
    mine = sheet.text
    until(lambda: file.exists() and file.read_text() == mine)
    # Neither an undo of nothing nor a drawing takes away what another tab has drawn.
    other.page.bring_to_front()
    other.page.keyboard.press("Control+z")
    assert "another tab" in other.said.lower()
    assert sheet.drafts == [mine]
    rod(other, (0.1, 0.3))
    assert sorted(sheet.drafts) == sorted([mine, other.text])
    assert file.read_text() == mine


def test_what_waits_for_the_server_is_written_behind_another_drawing(served):
    sheet, server, file = served
    rod(sheet)
    until(lambda: file.exists() and file.read_text() == sheet.text)
    server.stop()
    sheet.tool("pivot")
    sheet.click((0.2, 0.1))
    mine = sheet.text
    told = sheet.page.locator(".unsaved")
    told.wait_for()
    # It is kept: nothing is asked, and the line stays.
    sheet.menu("New")
    rod(sheet, (0.1, 0.3))
    other = sheet.text
    assert "rod.toml" in told.inner_text()
    server.start()
    until(lambda: file.read_text() == mine)
    told.wait_for(state="hidden")
    # The same with a page that is opened again.
    sheet.menu("Back to rod.toml")
    server.stop()
    sheet.page.keyboard.press("Control+z")
    mine = sheet.text
    told.wait_for()
    sheet.menu("Drafts")
    sheet.page.locator(".draft button", has_text="mechanism").first.click()
    sheet.page.wait_for_function(f"(text) => {STUDIO}.text === text", arg=other)
    sheet.page.goto("about:blank")
    server.start()
    sheet.page.goto(server.address)
    sheet.page.wait_for_selector(".studio.ready")
    assert sheet.text == other
    until(lambda: file.read_text() == mine)


def test_a_file_that_was_changed_behind_another_drawing_is_not_written_over(served):
    sheet, _, file = served
    rod(sheet)
    mine = sheet.text
    until(lambda: file.exists() and file.read_text() == mine)
    sheet.menu("New")
    rod(sheet, (0.1, 0.3))
    other = sheet.text
    changed = mine.replace("rod", "pole")
    file.write_text(changed)
    sheet.reload()
    assert sheet.text == other
    sheet.menu("Back to rod.toml")
    assert sheet.text == file.read_text() == changed
    assert sorted(sheet.drafts) == sorted([mine, other])
    # What was drawn before has its undo.
    sheet.menu("Drafts")
    sheet.page.locator(".draft button", has_text="rod").first.click()
    sheet.page.wait_for_function(f"(text) => {STUDIO}.text === text", arg=mine)
    sheet.page.keyboard.press("Control+z")
    assert "link" not in sheet.text


def test_a_text_with_an_error_has_its_own_drawing_after_a_reload(sheet):
    rod(sheet)
    sheet.page.locator(".editor .cm-content").click()
    sheet.press("Control+End")
    sheet.page.keyboard.type("oops")
    sheet.reload()
    assert sheet.state == "broken"
    drawing = sheet.page.locator(".studio.stale .drawing svg")
    assert drawing.count() == 1
    # A file with an error has none, and not that of the file before.
    sheet.page.evaluate(f"() => {STUDIO}.open({{ name: 'a.toml', text: 'format = 1\\noops' }})")
    assert sheet.state == "broken"
    assert drawing.count() == 0


def test_the_studio_is_at_one_port_and_says_where_else():
    with socket.socket() as taken:
        taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        taken.bind(("127.0.0.1", 7433))
        taken.listen()
        server = Server()
        assert ":7433/" not in server.address
        assert "port 7433 is taken" in server.stop()
    server = Server()
    assert server.address == "http://127.0.0.1:7433/"
    server.stop()


def test_undo_in_motion_leaves_the_file(sheet):
    sheet.open_template("four_bar")
    sheet.tool("trace")
    sheet.click((0, 0))
    before = sheet.text
    sheet.page.locator(".modes button[value=motion]").click()
    field = sheet.page.locator(".live.ready .driver-rows input[type=number]").first
    start = field.input_value()
    field.fill("90")
    field.press("Enter")
    sheet.page.locator(".middle").click(position={"x": 5, "y": 5})
    sheet.page.keyboard.press("Control+z")
    assert sheet.text == before
    assert sheet.page.locator(".studio.motion").count() == 1
    assert field.input_value() == start

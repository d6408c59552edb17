#include "meshlab/host_workarounds/number_fields.h"

#include <QDoubleSpinBox>
#include <QDoubleValidator>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>

#include "meshlab/host_workarounds/filter_dialog.h"

namespace {

/// Replaces commas by points, then asks another validator.
class PointValidator : public QValidator {
  public:
    PointValidator(const QValidator* numbers, QObject* parent)
        : QValidator(parent), numbers_(numbers) {}

    State validate(QString& text, int& cursor) const override {
        text.replace(',', '.');
        return numbers_ == nullptr ? Acceptable : numbers_->validate(text, cursor);
    }

    void fixup(QString& text) const override {
        if (numbers_ != nullptr) numbers_->fixup(text);
    }

  private:
    const QPointer<const QValidator> numbers_;
};

template <class Widget>
Widget* widgetAt(const QGridLayout* grid, int row, int column) {
    QLayoutItem* item = grid->itemAtPosition(row, column);
    return item == nullptr ? nullptr : qobject_cast<Widget*>(item->widget());
}

/// Calls `use(label, field)` for every line of text beside one of these labels.
template <class Use>
void forEachField(const QWidget* dialog, const QStringList& labels, Use use) {
    for (const QGridLayout* grid : dialog->findChildren<QGridLayout*>())
        for (int row = 0; row < grid->rowCount(); ++row) {
            const auto* label = widgetAt<QLabel>(grid, row, 0);
            auto* field = widgetAt<QLineEdit>(grid, row, 1);
            if (label != nullptr && field != nullptr && labels.contains(label->text()))
                use(label->text(), field);
        }
}

void prepareNumbers(const QWidget* dialog, const QStringList& labels) {
    for (const QDoubleSpinBox* box : dialog->findChildren<QDoubleSpinBox*>())
        if (auto* field = box->findChild<QLineEdit*>())
            field->setValidator(new PointValidator(field->validator(), field));
    forEachField(dialog, labels, [](const QString&, QLineEdit* field) {
        auto* numbers = new QDoubleValidator(field);
        numbers->setLocale(QLocale::c());
        field->setValidator(new PointValidator(numbers, field));
    });
}

}  // namespace

void checkNumberFields(const QStringList& labels) {
    whenDialogOpens([=](const QWidget* dialog) { prepareNumbers(dialog, labels); });
}

QString fieldWithoutNumber(const QStringList& labels, const QStringList& integers) {
    QString found;
    const QWidget* dialog = openFilterDialog();
    if (dialog == nullptr) return found;
    forEachField(dialog, labels, [&](const QString& label, const QLineEdit* field) {
        bool isNumber = false;
        if (integers.contains(label))
            field->text().toInt(&isNumber);
        else
            field->text().toDouble(&isNumber);
        if (!isNumber && found.isEmpty()) found = label + ": \"" + field->text() + "\"";
    });
    return found;
}
